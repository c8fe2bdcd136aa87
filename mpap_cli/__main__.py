"""What ``mpap`` and ``python -m mpap_cli`` run: signals are heeded before all else is imported."""

from mpap_cli.cli.interruption import ended_by_signals


def main() -> None:
    """Run the command line; from here on Ctrl-C ends in one line and exit code 130."""
    with ended_by_signals(to_the_end=True):
        from mpap_cli.cli import main as command_line  # noqa: PLC0415  # takes its time

        command_line.main()


if __name__ == "__main__":
    main()
