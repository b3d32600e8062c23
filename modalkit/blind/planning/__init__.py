"""Plan a test before it is made, or look back at one: what it tells apart, and which change of it buys most."""

from modalkit.blind.planning.forecast import Advice, Forecast, Outlook, forecast
from modalkit.blind.planning.told import Told, by_default

__all__ = ["Advice", "Forecast", "Outlook", "Told", "by_default", "forecast"]
