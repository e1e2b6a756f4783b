"""A live loop recorded for Rerun, where that is installed; a clear word where it is not."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import pytest
from test_live import touches

import palpate
import palpate.rerun


def test_without_rerun_it_says_what_is_missing(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(ImportError, match="pip install rerun-sdk"):
        palpate.rerun.RerunLog(palpate.LiveLoop(), path=tmp_path / "a.rrd")
    with pytest.raises(ValueError, match="colour"):
        palpate.rerun.RerunLog(palpate.LiveLoop(), path="a.rrd", colour="z")
    with pytest.raises(ValueError, match="one of them"):
        palpate.rerun.RerunLog(palpate.LiveLoop())


class Recording:
    """Stands for a recording and for the module: keeps what is logged."""

    def __init__(self) -> None:
        self.logged: list[tuple[int, str, str, dict]] = []
        self.touch = 0

    def set_time(self, timeline: str, *, sequence: int) -> None:
        assert timeline == "touch"
        self.touch = sequence

    def log(self, name: str, what: tuple[str, tuple, dict]) -> None:
        self.logged.append((self.touch, name, what[0], what[2]))

    def flush(self) -> None:
        self.logged.append((self.touch, "", "flushed", {}))

    def __getattr__(self, kind: str) -> object:
        return lambda *values, **named: (kind, values, named)


@pytest.mark.parametrize("colour", ["S", "R"])
def test_every_step_is_logged(monkeypatch: pytest.MonkeyPatch, colour: str) -> None:
    recording = Recording()
    monkeypatch.setitem(sys.modules, "rerun", recording)  # type: ignore[arg-type]
    loop = palpate.LiveLoop()
    with palpate.rerun.RerunLog(loop, recording=recording, colour=colour, grid=9) as log:
        log.log(None)
        for row in touches(15):
            log.log(loop.hear(row))
        log.log(loop.finish())
    last = {name: (kind, named) for touch, name, kind, named in recording.logged if touch == 15}
    kinds = {name: kind for name, (kind, _) in last.items()}
    assert kinds["palpate/touches"] == "Points3D" and kinds["palpate/next"] == "Arrows3D"
    assert kinds["palpate/words"] == "TextLog" and kinds["palpate/values/u_S"] == kinds["palpate/values/radius"] == "Scalars"
    for name in ("palpate/surface", "palpate/doubt"):
        kind, mesh = last[name]
        assert kind == "Mesh3D" and len(mesh["vertex_positions"]) == len(mesh["vertex_colors"]) > 20
        assert mesh["triangle_indices"].max() < len(mesh["vertex_positions"])
    assert {touch for touch, *_ in recording.logged} >= set(range(1, 16)) and recording.logged[-1][2] == "flushed"


@pytest.mark.skipif(importlib.util.find_spec("rerun") is None, reason="rerun-sdk is not installed")
def test_a_recording_is_written(tmp_path: Path) -> None:
    file, loop = tmp_path / "touches.rrd", palpate.LiveLoop()
    with palpate.rerun.RerunLog(loop, path=file) as log:
        for row in touches(12):
            log.log(loop.hear(row))
        log.log(loop.finish())
    held = file.read_bytes()
    assert len(held) > 5000
    for name in (b"palpate/surface", b"palpate/touches", b"palpate/next", b"palpate/doubt"):
        assert name in held
