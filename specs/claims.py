"""Which parts of a body each sub-task claims, in words."""

from specs.binding import BoundTask


def claims_of(task: BoundTask) -> dict[str, tuple[str, ...]]:
    """By name of sub-task: limbs and joint groups that it claims whole, and single joints."""
    body = task.body
    parts = {
        name: frozenset(body.joints(name).tolist()) for name in (*body.map.limbs, *body.map.groups)
    }
    found: dict[str, tuple[str, ...]] = {}
    for name, field in zip(task.graph.order, task.fields, strict=True):
        left, said = {int(dof) for dof in field.claims}, []
        for part, dofs in parts.items():
            if dofs and dofs <= left:
                said.append(part)
                left -= dofs
        found[name] = (*said, *(body.dof_name(dof) for dof in sorted(left)))
    return found
