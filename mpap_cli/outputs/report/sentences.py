"""The summary: what was found, in sentences."""

from collections import Counter
from itertools import islice

from mpap_cli.outputs.report.clusters import ClusterSection
from mpap_cli.outputs.report.presses import lead_of
from mpap_cli.outputs.report.runs import Row, Runs, number
from mpap_cli.outputs.text_table import count

_MOST_NAMED = 100


def sentences(runs: Runs, sections: list[ClusterSection]) -> list[str]:
    """Return one sentence or two for each command that was run."""
    return [
        *_learnt(runs, sections),
        *_scored(runs),
        *_predicted(runs),
        *_novelty(runs),
        *_extracted(runs),
        *_compared(runs),
    ]


def _learnt(runs: Runs, sections: list[ClusterSection]) -> list[str]:
    """Tell of the models learnt."""
    results = runs.by_command.get("learn") or runs.by_command.get("merge")
    if results is None:
        return []
    found = []
    for section in sections:
        n_seen = sum(card.observations for card in section.cards)
        text = (
            f"{n_seen:,} {section.what} of {count(len(results.inputs), 'input file')} make "
            f"{count(len(section.cards), 'cluster')}."
        )
        pressed = [card for card in section.cards if card.presses and card.p is not None]
        if pressed:
            worst = max(pressed, key=lambda card: (card.p or 0.0, card.presses))
            text += (
                f" Cluster {worst.cluster} meant a collision most often: p {worst.p:.2f}, "
                f"{count(worst.presses, 'press')}, {count(worst.observations, 'observation')}."
            )
        else:
            text += " Nothing is known of collisions: no press fell into any of them."
        found.append(text)
    return found


def _scored(runs: Runs) -> list[str]:
    """Tell how well collisions were predicted."""
    rows = list(runs.rows("evaluate", "auc.csv", _MOST_NAMED))
    if not rows:
        return []
    first, found = rows[0], []
    if first["auc"]:
        name = " ".join(part for part in (first["method"], first["feature"], first["bins"]) if part)
        text = f"{name} has a held-out AUC of {_with_interval(first)} ({first['protocol']})"
        others = [f"{row['method']} {float(row['auc']):.2f}" for row in rows[1:] if row["auc"]]
        found.append(f"{text}; beside it {', '.join(others)}." if others else f"{text}.")
    else:
        found.append("No AUC: only one class was scored.")
    presses = list(runs.rows("evaluate", "presses.csv"))
    if presses:
        announced = sum(lead_of(row) > 0 for row in presses)
        by_alarm = any(row.get("alarm_lead_s") for row in presses)
        how = "by an alarm" if by_alarm else "at the threshold asked for"
        words = count(len(presses), "press")
        found.append(f"{announced} of {words} were announced before they came ({how}).")
    return found


def _with_interval(row: Row) -> str:
    if not row["auc_low"]:
        return f"{float(row['auc']):.2f}"
    return f"{float(row['auc']):.2f} [{float(row['auc_low']):.2f}, {float(row['auc_high']):.2f}]"


def _predicted(runs: Runs) -> list[str]:
    """Tell what was predicted in other logs."""
    actions = Counter(line[0] for line in runs.chosen("predict", "decisions.csv", ["action"]))
    if not actions:
        return []
    total = sum(actions.values())
    parts = [f"{name} {100 * n / total:.0f} %" for name, n in actions.most_common(_MOST_NAMED)]
    return [f"Decisions at {total:,} images: {', '.join(parts)}."]


def _novelty(runs: Runs) -> list[str]:
    """Tell how new each log was."""
    observed: Counter[tuple[str, str]] = Counter()
    unknown: Counter[tuple[str, str]] = Counter()
    novel: Counter[tuple[str, str]] = Counter()
    for row in runs.rows("novelty", "novelty.csv"):
        key, n = (row["log_index"], row["log"]), int(row["observations"])
        observed[key] += n
        novel[key] += int(row["novel"])
        unknown[key] += round(n * (number(row["percent_unknown_at_start"]) or 0.0) / 100)
    parts = []
    for place, (key, n) in enumerate(islice(observed.items(), _MOST_NAMED)):
        share, words = (novel, "new") if place == 0 else (unknown, "unknown when it began")
        parts.append(f"{key[1]} {100 * share[key] / n:.0f} % {words}")
    return [f"Novelty: {', '.join(parts)}."] if parts else []


def _extracted(runs: Runs) -> list[str]:
    """Tell what was cut out."""
    rows = list(runs.chosen("extract", "segments.csv", ["start_s", "end_s", "reason"]))
    if not rows:
        return []
    kept_s = sum(float(end) - float(start) for start, end, _ in rows)
    reasons = Counter(reason for _, _, reason in rows)
    words = ", ".join(f"{n} {reason}" for reason, n in reasons.most_common(_MOST_NAMED))
    return [f"{count(len(rows), 'segment')} of {kept_s:,.0f} s in all were cut out ({words})."]


def _compared(runs: Runs) -> list[str]:
    """Tell which log the others explain least."""
    rows = list(runs.chosen("compare", "compare.csv", ["log", "against", "percent_unknown"]))
    shares = [(float(share), log, against) for log, against, share in rows if share]
    if not shares:
        return []
    share, log, against = max(shares)
    return [f"Of {log} {share:.0f} % is unknown to {against}, the most of all pairs."]
