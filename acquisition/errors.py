"""The one small error family: every message states what was found, where, and what to do."""


class ModalkitError(Exception):
    """Base of every error modalkit raises on purpose; the command line prints it in one line."""


class InputError(ModalkitError):
    """A file or array cannot be used as it is."""


class StudyError(ModalkitError):
    """A study file asks for something that does not exist or does not fit together."""


class EstimationError(ModalkitError):
    """The data do not carry what was asked of them."""


def in_one_line(error: Exception, *, longest: int = 200) -> str:
    """Return what the error of a library states, in one line of at most so many characters."""
    return " ".join(str(error).split())[:longest]


def cannot_open(path: object, error: Exception) -> InputError:
    """Return the error of a file that the system does not open, with the reason that it gives."""
    reason = getattr(error, "strerror", None) or error
    return InputError(f"{path}: cannot be opened ({reason}); check the path")
