"""Results as xarray Datasets with units, and NetCDF files."""
