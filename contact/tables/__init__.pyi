from .builder import TableBuilder as TableBuilder
from .errors import TableErrors as TableErrors
from .samples import TableSampler as TableSampler
from .table_range import TableRange as TableRange
