"""Universal files: time records, FRFs, spectra, coherence, geometry and modes in and out."""

from acquisition.uff.content import DatasetInfo, UffContent
from acquisition.uff.functions.values58 import Function58
from acquisition.uff.read import read_functions, read_uff
from acquisition.uff.writing.write import write_uff

__all__ = ["DatasetInfo", "Function58", "UffContent", "read_functions", "read_uff", "write_uff"]
