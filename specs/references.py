"""Names of sub-tasks, once fragments are put in: short names become full ones.

A name is looked up in the fragment that it stands in, then in what is around that. The name of a
use of a fragment stands for its sub-tasks: to come after it is to come after all that end it, to
be followed by it is to be followed by its first.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from specs.assembling import Assembly
from specs.reading import Path_


@dataclass
class Used:
    """A fragment that was put in, as full names of sub-tasks."""

    leaves: list[str]  # all of them
    ends: list[str]  # those that none of the others comes after


@dataclass(frozen=True)
class Surroundings:
    """Where the names of a sub-task are looked up: `first.` is in the fragment `first`."""

    names: str
    after: str  # the names of its `after`, which may be those of the use that it is in


class References:
    """Rewrites names.

    Args:
        made: the document; it is changed.
        around: of each sub-task.
        used: the fragments that were put in, by the full name of the use.
    """

    def __init__(
        self, made: Assembly, around: Sequence[Surroundings], used: Mapping[str, Used]
    ) -> None:
        self.made, self.around, self.used = made, around, used
        items = made.data.get("subtasks")
        self.items: list[Any] = items if isinstance(items, list) else []
        named = (i.get("name") for i in self.items if isinstance(i, dict))
        self.known = {name for name in named if isinstance(name, str)} | used.keys()

    def rewrite(self) -> None:
        """Rewrite them all.

        Raises:
            SpecError: one of several is to be over, and the fragment ends with several.
        """
        for i, (item, around) in enumerate(zip(self.items, self.around, strict=True)):
            if not isinstance(item, dict):
                continue
            place: Path_ = ("subtasks", i)
            after = item.get("after")
            if isinstance(after, list):
                item["after"] = self._all(after, around.after, (*place, "after"))
            elif isinstance(after, dict):
                item["after"] = {
                    policy: self._some(names, around.after, (*place, "after", policy))
                    for policy, names in after.items()
                }
            for key in ("while", "otherwise"):
                if key in item:
                    item[key] = self._first(item[key], around.names)
        self._rewrite_list("groups", "members")
        self._rewrite_list("tempo_map", "subtask")

    def _rewrite_list(self, key: str, inner: str) -> None:
        """The members of groups, and the sub-tasks of a tempo map."""
        entries = self.made.data.get(key)
        if not self.used or not isinstance(entries, list):
            return
        changed = [dict(entry) if isinstance(entry, dict) else entry for entry in entries]
        for i, entry in enumerate(changed):
            said = entry.get(inner) if isinstance(entry, dict) else None
            if isinstance(said, str):
                entry[inner] = self._first(said, "")
            elif isinstance(said, list):
                entry[inner] = self._spread(said, "", (key, i, inner), ends=False)
        self.made.data[key] = changed

    def _all(self, names: list[Any], around: str, place: Path_) -> list[Any]:
        return self._spread(names, around, place, ends=True)

    def _some(self, names: Any, around: str, place: Path_) -> Any:
        """Of those that one of is to be over; with `all` a fragment may end with several."""
        if not isinstance(names, list):
            return names
        for j, name in enumerate(names):
            use = self._use(self._full(name, around))
            if place[-1] != "all" and use is not None and len(use.ends) > 1:
                raise self.made.document().error(
                    f"{name!r} ends with several sub-tasks ({', '.join(use.ends)}): name those"
                    " that are meant",
                    (*place, j),
                )
        return self._spread(names, around, place, ends=True)

    def _spread(self, names: list[Any], around: str, place: Path_, *, ends: bool) -> list[Any]:
        """Full names; of a fragment all that it stands for, at the place of its name."""
        found: list[Any] = []
        places = [self.made.positions.pop((*place, j), None) for j in range(len(names))]
        for name, where in zip(names, places, strict=True):
            full = self._full(name, around)
            use = self._use(full)
            added = [full] if use is None else use.ends if ends else use.leaves
            for one in added:
                if where is not None:
                    self.made.positions[(*place, len(found))] = where
                found.append(one)
        return found

    def _first(self, name: Any, around: str) -> Any:
        """The full name; of a fragment that of its first sub-task."""
        full = self._full(name, around)
        use = self._use(full)
        return full if use is None or not use.leaves else use.leaves[0]

    def _use(self, full: Any) -> Used | None:
        return self.used.get(full) if isinstance(full, str) else None

    def _full(self, name: Any, around: str) -> Any:
        """The full name of what is meant, from the inside out; what is unknown stays as it is."""
        if not isinstance(name, str):
            return name
        while around and around + name not in self.known:
            around = around[: around.rstrip(".").rfind(".") + 1]
        return around + name
