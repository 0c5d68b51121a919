from .hubs import HubCompliance as HubCompliance
from .hubs import hub_compliance as hub_compliance
from .pads import RailCompliance as RailCompliance
from .pads import RailPads as RailPads
from .pads import rail_compliance as rail_compliance
from .sleepers import sleeper_compliance as sleeper_compliance
