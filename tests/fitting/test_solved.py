"""Linear equations of a fit whose derivatives may have exploded."""

import numpy as np

from tendonlab.fitting.fitted import solved


def test_a_regular_precision_is_solved_exactly() -> None:
    precision, push = np.array([[4.0, 1.0], [1.0, 3.0]]), np.array([1.0, 2.0])
    np.testing.assert_allclose(precision @ solved(precision, push), push, rtol=1e-14)


def test_what_a_singular_precision_does_not_determine_stays() -> None:
    """Of one matrix, and of several at once of which one is singular."""
    singular, regular = np.array([[2.0, 0.0], [0.0, 0.0]]), np.eye(2)
    np.testing.assert_allclose(solved(singular, np.array([4.0, 0.0])), [2.0, 0.0])
    several = solved(np.array([singular, regular]), np.array([[[4.0], [0.0]], [[1.0], [5.0]]]))
    np.testing.assert_allclose(several[..., 0], [[2.0, 0.0], [1.0, 5.0]])
