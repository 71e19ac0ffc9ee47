"""An editor that reads the shipped schema completes primitives and parameters, and checks them."""

import importlib.util
from pathlib import Path

import pytest

from specs import SHIPPED_SCHEMA, available_primitives, library

pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning")
STEP = "task: x\nsubtasks:\n  - name: a\n"


def client():
    """The module beside this file; test folders are no packages."""
    path = Path(__file__).with_name("language_server.py")
    found = importlib.util.spec_from_file_location("language_server", path)
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


def test_an_editor_completes_and_checks() -> None:
    """One test, so that one server does it all."""
    server = client().LanguageServer(SHIPPED_SCHEMA)
    try:
        kinds = server.completions(STEP + "    primitive: |\n")
        assert set(kinds) == set(available_primitives())
        reach = server.completions(STEP + "    primitive: go-to-point\n    |\n")
        assert {"limb", "to", "via", "palm", "travel", "beats", "after", "while"} <= set(reach)
        assert not {"frequency", "posture", "limp", "name"} & set(reach)
        assert reach["palm"].startswith("where it faces; default: onto the landmark")
        swing = server.completions(
            "task: x\nbackground:\n  - {name: a, primitive: oscillate, b|}\n"
        )
        assert {"beats_per_cycle", "joints", "claims"} <= set(swing)
        assert not {"beats", "after"} & set(swing), "the background has no times"
        inside = (
            "task: x\nfragments:\n  f:\n    subtasks:\n      - name: a\n        primitive: hold\n"
        )
        assert {"limb", "joints", "repeat"} <= set(server.completions(inside + "        |\n"))
        landmarks = server.completions(STEP + "    primitive: go-to-point\n    to: |\n")
        assert {"head.top", "left_hip"} <= set(landmarks)
        controllers = server.completions(STEP + "    primitive: get-posture\n    controller: |\n")
        assert {"pd-servo", "torque-field", "impedance", "endpoint-force"} == set(controllers)
        assert {"tempo_map", "landmarks", "include", "fragments"} <= set(server.completions("|\n"))
        for text in (library()["macarena"].read_text(), library()["wave"].read_text()):
            assert server.complaints(text) == []
        wrong = "    primitive: hold\n    limbs: right_arm\n    beats: many\n"
        assert [said.split(".")[0] for said in server.complaints(STEP + wrong)] == [
            "6: Incorrect type",
            "5: Property limbs is not allowed",
        ]
    finally:
        server.close()
