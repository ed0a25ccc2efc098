"""The errors of the simulation core: each message is one line that names what, where and the remedy."""

__all__ = ["FileProblem", "OutlineError", "OutlineWarning", "SimCoreError", "WeaveError", "WrongArgument"]


class SimCoreError(ValueError):
    """Anything the simulation core refuses to do; the command line prints it as one line and exits with 1."""


class WeaveError(SimCoreError):
    """A draft, yarn or sett that cannot be woven, or a weave file that does not say what it must."""


class OutlineError(SimCoreError):
    """A panel outline that cannot be meshed (too few points, self-crossing, zero area, ...)."""


class OutlineWarning(UserWarning):
    """A panel outline that was changed before meshing, such as a hole merged with the outline it touches."""


class FileProblem(SimCoreError):
    """A file that cannot be read or written; the message begins with its path."""


class WrongArgument(SimCoreError):  # noqa: N818 - an argument of a command, told with its name
    """An argument of a command that its other arguments forbid; the command line exits with 2."""
