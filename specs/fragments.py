"""Fragments: a list of sub-tasks that is written once and used many times.

fragments:
  tap:
    parameters: {limb: , place: , pause: 1}     # with their defaults; nothing: must be given
    subtasks:
      - {name: go, words: Tap $place, primitive: go-to-point, limb: $limb, to: $place}
      - {name: back, primitive: get-posture, limb: $limb, posture: rest, beats: $pause}
subtasks:
  - {name: first, fragment: tap, with: {limb: right_arm, place: chest.front}}
  - {name: second, fragment: tap, with: {limb: left_arm, place: head.top, pause: 2}}

A value that is `$name` becomes the argument, whatever it is; within a text the argument is put in
as text, and `$$` is a dollar. Nothing else is computed. The sub-tasks are called first.go,
first.back and so on; inside a fragment they call each other by their short names.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from string import Template
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from sim import unknown
from specs.assembling import Assembly
from specs.conditions import Join, Name
from specs.errors import SpecError
from specs.reading import DEEPEST, Document, Path_
from specs.references import References, Surroundings, Used
from specs.validating import validate

Parameter = Annotated[str, Field(pattern=r"^[a-z_][a-z0-9_]*$", max_length=100)]
MOST_SUBTASKS = 5_000  # that a task has where a fragment is put in
LONGEST = 10_000  # characters of a text with arguments
WHOLE = re.compile(r"\$(?:([a-z_][a-z0-9_]*)|\{([a-z_][a-z0-9_]*)\})")


class Fragment(BaseModel):
    """Sub-tasks with parameters."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    parameters: dict[Parameter, Any] = {}  # their defaults; null for one that must be given
    subtasks: Annotated[tuple[dict[str, Any], ...], Field(min_length=1)]  # in terms of $parameters


class Use(BaseModel):
    """The sub-tasks of a fragment, at this place, with these arguments."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    name: Name  # its sub-tasks are called NAME.a, NAME.b …
    fragment: Name  # which of the fragments
    with_: Annotated[dict[Parameter, Any], Field(alias="with")] = {}  # parameter: argument
    after: tuple[Name, ...] | Join | None = None  # what must be over before; default: one above


@dataclass(frozen=True)
class Scope:
    """Where names and parameters are looked up: in a use of a fragment, or in the task itself."""

    prefix: str = ""  # of the names in it: `first.`
    fragments: tuple[str, ...] = ()  # that it is in, outermost first
    arguments: Mapping[str, tuple[Any, Path_]] = field(default_factory=dict)  # and their places
    before: Any = None  # what the fragment as a whole comes after
    before_in: str = ""  # and where those names are looked up
    before_at: Path_ = ()  # and where they stand
    spared: bool = False  # whether it begins instead of something else


def put_in_fragments(document: Document) -> Document:
    """A document in which every use of a fragment is replaced by the fragment's sub-tasks.

    Raises:
        SpecError: a fragment that does not exist or uses itself, an argument that is missing or
            not asked for, or more sub-tasks than a task can have.
    """
    data = document.data
    if not isinstance(data, dict):
        return document
    items = data.get("subtasks")
    uses = isinstance(items, list) and any(isinstance(i, dict) and "fragment" in i for i in items)
    if not uses and "fragments" not in data:
        return document
    return _Expansion(document).whole()


class _Expansion:
    """Puts fragments in, one after the other."""

    def __init__(self, document: Document) -> None:
        self.document, self.made = document, Assembly(document)
        self.fragments = self._fragments()
        self.items: list[Any] = []
        self.around: list[Surroundings] = []
        self.used: dict[str, Used] = {}

    def whole(self) -> Document:
        document, made = self.document, self.made
        for key, value in document.data.items():
            if key == "subtasks" and isinstance(value, list):
                made.data[key] = self.items
                made.mark(document, (key,), (key,))
                self._put_in(value, (key,), Scope())
            elif key != "fragments":
                made.data[key] = value
                made.mark_all(document, (key,), (key,), value)
        if self.items:
            References(made, self.around, self.used).rewrite()
        return made.document()

    def _fragments(self) -> dict[str, Fragment]:
        written = self.document.data.get("fragments", {})
        if not isinstance(written, dict):
            said = "fragments: expected names, each with parameters and subtasks"
            raise self.document.error(said, ("fragments",))
        return {
            name: validate(self.document, ("fragments", name), value, Fragment)
            for name, value in written.items()
        }

    def _put_in(self, items: Sequence[Any], path: Path_, scope: Scope) -> Used:
        """Add the sub-tasks of a list, those of fragments among them."""
        otherwise = [item.get("otherwise") for item in items if isinstance(item, dict)]
        spared = {name for name in otherwise if isinstance(name, str)}
        found = Used([], [])
        above: str | None = None
        followed = set().union(*(_names_in(i.get("after")) for i in items if isinstance(i, dict)))
        last: list[str] = []  # those that may end the list
        for i, written in enumerate(items):
            made = Assembly(self.document) if _is_use(written) else self.made
            here: Path_ = ("subtasks", len(self.items))
            item = self._filled(written, (*path, i), here, scope, made)
            if not isinstance(item, dict) or not isinstance(item.get("name"), str):
                self._add(item, Surroundings(scope.prefix, scope.prefix))
                continue
            short, after_in = item["name"], scope.prefix
            followed |= _names_in(item.get("after"))
            default = "after" not in item and "while" not in item and short not in spared
            if default and above is not None:
                ends = self._ends(scope.prefix + above)
                followed.add(above)
                if made is not self.made or ends != found.leaves[-1:]:
                    item["after"], after_in = ends, ""
            elif scope.before is not None and (default or item.get("after") == []):
                item["after"], after_in = scope.before, scope.before_in
                if scope.before_at:
                    place = (*here, "after")
                    made.mark_all(self.document, scope.before_at, place, scope.before)
            elif scope.spared and item.get("after") == []:
                said = f"{short}: its fragment begins instead of something: name what this is after"
                raise self.document.error(said, (*path, i, "after"))
            around = Surroundings(scope.prefix, after_in)
            name = scope.prefix + short
            if made is not self.made:
                leaves = self._use(
                    made.document(), item, (*path, i), scope, around, short in spared
                )
            else:
                item["name"], leaves = name, [name]
                self._add(item, around)
            found.leaves += leaves
            last += [] if "while" in item else [short]
            above = short
        for short in last:
            found.ends += [] if short in followed else self._ends(scope.prefix + short)
        return Used(found.leaves, found.ends or found.leaves[-1:])

    def _add(self, item: Any, around: Surroundings) -> None:
        self.items.append(item)
        self.around.append(around)

    def _ends(self, name: str) -> list[str]:
        return list(self.used[name].ends) if name in self.used else [name]

    def _use(
        self,
        seen: Document,
        item: dict[str, Any],
        place: Path_,
        scope: Scope,
        around: Surroundings,
        spared: bool,
    ) -> list[str]:
        """Put a fragment in; the full names of its sub-tasks."""
        here: Path_ = ("subtasks", len(self.items))
        use = validate(seen, here, item, Use)
        if use.fragment not in self.fragments:
            message = unknown("fragment", use.fragment, self.fragments)
            raise seen.error(message, (*here, "fragment"))
        within = (*scope.fragments, use.fragment)
        if use.fragment in scope.fragments:
            said = f"a fragment uses itself: {' -> '.join(within)}"
            raise seen.error(said, (*here, "fragment"))
        if len(within) > DEEPEST:
            said = f"fragments within fragments, deeper than {DEEPEST} levels"
            raise seen.error(said, (*here, "fragment"))
        if len(self.items) > MOST_SUBTASKS:
            said = f"more than {MOST_SUBTASKS} sub-tasks come from fragments"
            raise seen.error(said, (*here, "fragment"))
        written = (*place, "after") in self.document.positions
        before_at = (*place, "after") if written else scope.before_at
        inner = Scope(
            prefix=f"{scope.prefix}{use.name}.",
            fragments=within,
            arguments=self._arguments(use, place, scope, seen, here),
            before=item.get("after"),
            before_in=around.after,
            before_at=before_at,
            spared=spared,
        )
        subtasks = self.document.data["fragments"][use.fragment]["subtasks"]
        used = self._put_in(subtasks, ("fragments", use.fragment, "subtasks"), inner)
        self.used[scope.prefix + use.name] = used
        return used.leaves

    def _arguments(
        self, use: Use, place: Path_, scope: Scope, seen: Document, here: Path_
    ) -> dict[str, tuple[Any, Path_]]:
        """The arguments of a use, those by default among them, and where each stands."""
        expected = self.fragments[use.fragment].parameters
        for name in use.with_:
            if name not in expected:
                message = unknown(f"parameter of {use.fragment!r}", name, expected)
                raise seen.error(message, (*here, "with", name), key=True)
        found: dict[str, tuple[Any, Path_]] = {}
        for name, default in expected.items():
            if name in use.with_:
                found[name] = use.with_[name], self._origin((*place, "with", name), scope)
            elif default is not None:
                found[name] = default, ("fragments", use.fragment, "parameters", name)
            else:
                said = f"{use.name}: {name!r} of the fragment {use.fragment!r} is not given"
                raise seen.error(said, here)
        return found

    # --- values ----------------------------------------------------------------------------

    def _filled(self, value: Any, old: Path_, new: Path_, scope: Scope, made: Assembly) -> Any:
        """A value with the arguments of a scope put in; what it is made of is remembered."""
        if isinstance(value, str) and scope.prefix and "$" in value:
            return self._text(value, old, new, scope, made)
        made.mark(self.document, old, new)
        if isinstance(value, dict):
            return {k: self._filled(v, (*old, k), (*new, k), scope, made) for k, v in value.items()}
        if isinstance(value, list):
            return [self._filled(v, (*old, i), (*new, i), scope, made) for i, v in enumerate(value)]
        return value

    def _text(self, text: str, old: Path_, new: Path_, scope: Scope, made: Assembly) -> Any:
        """A text with arguments put in; `$name` alone is the argument itself."""
        known = scope.arguments
        if (whole := known.get(_parameter(text))) is not None:
            value, origin = whole
            made.mark_all(self.document, origin, new, value)
            if old in self.document.keys:  # its key is that of the fragment
                made.keys[new] = self.document.keys[old]
            return value
        made.mark(self.document, old, new)
        template = Template(text)
        if not template.is_valid():
            raise self.document.error("$ stands before a parameter's name; $$ is a dollar", old)
        said = {}
        for asked in template.get_identifiers():
            if asked not in known:
                message = unknown(f"parameter of {scope.fragments[-1]!r}", asked, known)
                raise self.document.error(message, old)
            value, origin = known[asked]
            if isinstance(value, dict | list):
                message = f"{asked!r} is put into a text: expected a text or a number"
                raise self.document.error(message, origin)
            said[asked] = str(value).lower() if isinstance(value, bool) else str(value)
        filled = template.substitute(said)
        if len(filled) > LONGEST:
            raise self.document.error(f"a text longer than {LONGEST} characters", old)
        return filled

    def _origin(self, place: Path_, scope: Scope) -> Path_:
        """Where an argument stands: one that is a parameter itself, where that stands."""
        value: Any = self.document.data
        for step in place:
            value = value[step]
        _, origin = scope.arguments.get(_parameter(value), (None, place))
        return origin


def _is_use(item: Any) -> bool:
    return isinstance(item, dict) and "fragment" in item


def _parameter(value: Any) -> str:
    """The parameter that a value is; "" if it is none."""
    whole = WHOLE.fullmatch(value) if isinstance(value, str) else None
    return (whole[1] or whole[2]) if whole else ""


def _names_in(after: Any) -> set[str]:
    """The names in an `after`, in whatever way it is written."""
    if isinstance(after, dict):
        return set().union(*(_names_in(names) for names in after.values()))
    return {name for name in after if isinstance(name, str)} if isinstance(after, list) else set()


__all__ = ["Fragment", "SpecError", "Use", "put_in_fragments"]
