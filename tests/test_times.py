"""What jobs took."""

import json
from pathlib import Path

from workflow.run.job import KEYS, read_times


def test_times_that_are_not_whole_are_left_out(tmp_path: Path) -> None:
    folder = tmp_path / ".times"
    (folder / "yade").mkdir(parents=True)
    whole = dict.fromkeys(KEYS, 1.5)
    (folder / "yade" / "one.json").write_text(json.dumps(whole | {"own_memory_MB": 3.0}))
    (folder / "collect.json").write_text(json.dumps(whole))
    for name, text in (("cut", '{"wall_s": 1'), ("other", '{"wall_s": 1}'), ("list", "[1]")):
        (folder / f"{name}.json").write_text(text)
    assert list(read_times(tmp_path)) == [("collect", whole), ("yade", whole)]
    assert list(read_times(tmp_path / "nothing")) == []
