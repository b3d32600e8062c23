"""The one small error family: every message states what was found, where, and what to do."""


class ModalkitError(Exception):
    """Base of every error modalkit raises on purpose; the command line prints it in one line."""


class InputError(ModalkitError):
    """A file or array cannot be used as it is."""


class StudyError(ModalkitError):
    """A study file asks for something that does not exist or does not fit together."""


class EstimationError(ModalkitError):
    """The data do not carry what was asked of them."""
