"""A mapping that cannot be changed, so that a system with numbers in it is a value."""

from __future__ import annotations

from collections.abc import Iterator, Mapping


class FrozenNumbers(Mapping[str, float]):
    """Numbers by name. Equal to a dict with the same items; hashable; pickles and copies, unlike MappingProxyType."""

    __slots__ = ("_items",)

    def __init__(self, items: Mapping[str, float]) -> None:
        self._items = dict(items)

    def __getitem__(self, name: str) -> float:
        return self._items[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._items)

    def __len__(self) -> int:
        return len(self._items)

    def __or__(self, other: Mapping[str, float]) -> dict[str, float]:
        return {**self._items, **other}

    def __hash__(self) -> int:
        return hash(frozenset(self._items.items()))

    def __repr__(self) -> str:
        return repr(self._items)
