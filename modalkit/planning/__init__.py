"""Plan a test before it is made, or look back at one: what it tells apart, and which change of it buys most."""

from modalkit.planning.forecast import Advice, Forecast, TestForecast, forecast
from modalkit.planning.known import KnownTest, by_default

__all__ = ["Advice", "Forecast", "KnownTest", "TestForecast", "by_default", "forecast"]
