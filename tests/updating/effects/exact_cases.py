"""What several of the tests beside it need."""

from __future__ import annotations

import numpy as np
from effect_cases import LOOK
from updating_cases import BEAM

from updating import LIBRARY

SIZE = (BEAM.length, BEAM.width, BEAM.thickness)


def predicted(name: str, place: str, count: int = 5, **values: float) -> np.ndarray:
    predictor = LOOK[place]
    return predictor.predict(LIBRARY[name].state(predictor, values), count=count).frequency
