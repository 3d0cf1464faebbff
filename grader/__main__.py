"""`python -m grader`."""

from groundwork.clean_environment import restart_if_polluted


def main() -> None:
    """Run `spinbook grade`, which is all that the grader has without Spinbook."""
    restart_if_polluted("grader.__main__")
    from grader.command import grade
    from groundwork.plain_text import print_in_any_encoding

    print_in_any_encoding()
    grade(prog_name="python -m grader")


if __name__ == "__main__":
    main()
