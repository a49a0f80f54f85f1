"""`sher3` and `python -m sher3_cli`: imports nothing before it can answer an interrupt."""

import signal
import sys


def main() -> None:
    """Run the command line; an interrupt ends it with exit code 130, whenever it comes."""
    try:
        from sher3_common.interrupts import interrupt

        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # a job in the background ignores it
            signal.signal(signal.SIGINT, interrupt)
        from sher3_cli.root import main as run

        run()
    except KeyboardInterrupt:
        print("sher3: interrupted", file=sys.stderr)
        sys.exit(128 + signal.SIGINT)


if __name__ == "__main__":
    main()
