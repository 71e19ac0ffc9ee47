"""Groups: what is on at once, and by which rule its torques become one."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from primitives import Field as TorqueField
from sim import unknown
from specs.errors import SpecError
from specs.reading import Document

Rule = Literal["sum", "weighted", "dominant", "null-space"]
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]*$", max_length=100)]
Weight = Annotated[float, Field(ge=0, le=1e6)]


class Group(BaseModel):
    """Background entries, sub-tasks and other groups, combined by a rule.

    `sum` adds torques; `weighted` averages them where more than one is on; `dominant` lets the
    one with the strongest activation have the joints; `null-space` gives those named first
    what they ask for, and the others only what does not move the first.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    name: Name  # what it is called
    rule: Rule = "sum"  # by which the torques of its members become one
    # names of background entries, sub-tasks, and groups written above
    members: Annotated[tuple[Name, ...], Field(min_length=1)]
    weights: dict[Name, Weight] = {}  # of members, 1 by default: weighted and dominant

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if len(set(self.members)) < len(self.members):
            raise ValueError("a member is named twice")
        if self.weights and self.rule not in ("weighted", "dominant"):
            raise ValueError(f"the rule {self.rule} takes no weights")
        for name in self.weights:
            if name not in self.members:
                raise ValueError(unknown("member", name, self.members))
        return self


def check_groups(
    groups: Sequence[Group], fields: Mapping[str, TorqueField], document: Document
) -> None:
    """Refuse groups that cannot mean anything.

    Args:
        groups: those of a task.
        fields: of the background and the sub-tasks, by name.
        document: what the task was read from.

    Raises:
        SpecError: a member that does not exist or is in two groups, a group within itself, or
            a null-space group whose first members leave nothing or have nothing to protect.
    """
    names = {g.name: i for i, g in enumerate(groups)}
    owner: dict[str, str] = {}
    for i, group in enumerate(groups):
        if names[group.name] != i or group.name in fields:
            raise document.error(f"two things are called {group.name!r}", ("groups", i, "name"))
        for j, member in enumerate(group.members):
            place = ("groups", i, "members", j)
            if member not in fields and member not in names:
                raise document.error(unknown("member", member, [*fields, *names]), place)
            if member in owner:
                said = f"{member!r} is a member of {owner[member]!r} and of {group.name!r}"
                raise document.error(said, place)
            if names.get(member, -1) >= i:
                raise document.error(
                    f"{group.name!r} comes before its member {member!r}: write inner groups first",
                    place,
                )
            owner[member] = group.name
        if group.rule == "null-space":
            _check_priorities(group, groups, fields, document, i)


def leaves(name: str, groups: Sequence[Group]) -> list[str]:
    """The background entries and sub-tasks in a member, however deep."""
    inner = {g.name: g for g in groups}
    if name not in inner:
        return [name]
    return [leaf for member in inner[name].members for leaf in leaves(member, groups)]


def together(one: str, other: str, groups: Sequence[Group]) -> bool:
    """Whether two names are in one group, however deep: then a rule says what becomes of both."""
    return any({one, other} <= set(leaves(group.name, groups)) for group in groups)


def _check_priorities(
    group: Group,
    groups: Sequence[Group],
    fields: Mapping[str, TorqueField],
    document: Document,
    i: int,
) -> None:
    taken: set[int] = set()  # joints of which nothing is left
    for j, member in enumerate(group.members):
        place = ("groups", i, "members", j)
        own = [fields[leaf] for leaf in leaves(member, groups)]
        claimed = {int(dof) for field in own for dof in field.claims}
        if claimed and claimed <= taken:
            above = ", ".join(repr(m) for m in group.members[:j])
            raise document.error(
                f"nothing is left for {member!r}: {above} before it in {group.name!r} decide(s)"
                " every joint that it moves; put it first, or take another rule",
                place,
            )
        if j < len(group.members) - 1:
            if not all(callable(getattr(field, "jacobian", None)) for field in own):
                raise document.error(
                    f"{member!r} has no goal that could be protected from what comes after it in"
                    f" {group.name!r}: put it last, or outside",
                    place,
                )
            taken |= {int(dof) for f in own if f.unit == "rad" for dof in f.claims}


__all__ = ["Group", "Rule", "SpecError", "check_groups", "leaves", "together"]
