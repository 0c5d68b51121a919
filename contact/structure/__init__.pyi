from .hubs import HubCompliance as HubCompliance
from .hubs import hub_compliance as hub_compliance
