"""From FRFs to modes with uncertainties."""

from identification.identify import identify
from identification.model import ModalModel

__all__ = ["ModalModel", "identify"]
