"""The settings of what was learnt last in a results folder."""

from pathlib import Path

from mpap_cli.outputs.results_reader import has_results, read_results
from mpap_cli.params import Settings, make_settings, setting_fields


def learnt_settings(out: Path) -> Settings | None:
    """Return the settings that ``learn`` wrote; None where nothing was learnt.

    Raises
    ------
    OutputError
        If the results are mixed or damaged.
    """
    folder = out / "learn"
    if not has_results(folder):
        return None
    written = read_results(folder).settings
    keys = setting_fields()
    values = {key: value for key, value in written.items() if key in keys}
    return make_settings(str(written["profile"]), values)
