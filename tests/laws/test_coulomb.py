from tendonlab import _core

law = _core.friction.Coulomb(coulomb=0.3)


def test_its_force_has_its_level_at_any_speed_and_none_at_rest() -> None:
    assert law.force(velocity=[-100.0, -1e-9, 0.0, 1e-9, 100.0]).tolist() == [-0.3, -0.3, 0.0, 0.3, 0.3]


def test_its_level_counts_at_rest() -> None:
    assert law.level(velocity=0.0) == 0.3
