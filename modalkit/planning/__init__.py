"""Plan a test before it is made, or look back at one: which effects it separates, and which change of it gains most."""

from modalkit.planning.bench import Bench
from modalkit.planning.forecast import Advice, DesignForecast, Forecast, forecast

__all__ = ["Advice", "Bench", "DesignForecast", "Forecast", "forecast"]
