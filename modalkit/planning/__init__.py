"""Plan a test before it is made, or look back at one: what it tells apart, and which change of it buys most."""

from modalkit.planning.forecast import Advice, Forecast, Outlook, forecast
from modalkit.planning.known import Told, by_default

__all__ = ["Advice", "Forecast", "Outlook", "Told", "by_default", "forecast"]
