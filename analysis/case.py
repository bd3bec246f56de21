"""One case's result in words."""

from workflow.results.record import CaseRecord


def describe(record: CaseRecord) -> str:
    """Capacity and lock weights of a case, or the reason why it has none."""
    if record.error is not None:
        return f"{record.name} ({record.model}): no result: {record.error}"
    first = record.first_failure_load_N
    lines = [
        f"{record.name} ({record.model}): "
        f"V = {record.shear_N:.2f} N, M = {record.torque_Nm:.4f} N m",
        f"  load along the path: {record.load_N:.2f} N is carried, "
        f"{record.failed_load_N:.2f} N is not"
        + ("" if first is None else f"; first failure at {first:.2f} N"),
    ]
    if record.peak_spread is not None:
        lines.append(
            f"  spread of the peak: {100 * record.peak_spread:.2f} %"
            + ("" if record.is_peak else ", too far to rely on: the first failure is told instead")
        )
    if record.weights:
        lines.append("  lock  block  weight  mean shear / tau  largest / tau")
    lines += [
        f"  {each.lock:>4}  {each.block:5}  {each.weight:6.3f}  {each.mean_shear_ratio:16.3f}"
        f"  {each.max_shear_ratio:13.3f}"
        for each in record.weights
    ]
    return "\n".join(lines)
