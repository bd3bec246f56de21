"""What jobs took."""

from pathlib import Path

from workflow.results import BENCHMARKS, read_times

HEAD = "s\th:m:s\tcpu_time\n"


def test_times_are_those_of_the_jobs_that_were_measured(tmp_path: Path) -> None:
    folder = tmp_path / BENCHMARKS / "cases/yade"
    folder.mkdir(parents=True)
    (folder / "one.tsv").write_text(f"{HEAD}2.5\t0:00:02\t1.5\n")
    (folder / "two.tsv").write_text(f"{HEAD}0.1\t0:00:00\tNA\n")  # it ended at once
    assert list(read_times(tmp_path)) == [("yade", 2.5, 1.5)]
    assert list(read_times(tmp_path / "nothing")) == []
