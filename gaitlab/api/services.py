"""What the running application is made of."""

from dataclasses import dataclass

from prometheus_client import CollectorRegistry

from ..jobs.events import EventBroker
from ..storage.database import Database
from ..storage.files import FileStore
from ..storage.sealing import Sealing
from ..storage.settings import Settings
from .viewers import Viewers


@dataclass(frozen=True, kw_only=True)
class Services:
    """Made once per process."""

    settings: Settings
    database: Database
    files: FileStore
    sealing: Sealing
    events: EventBroker
    viewers: Viewers
    gauges: CollectorRegistry
    """What is counted in the database when Prometheus asks."""
