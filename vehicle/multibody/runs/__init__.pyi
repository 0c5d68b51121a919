from .history import VehicleHistory as VehicleHistory
