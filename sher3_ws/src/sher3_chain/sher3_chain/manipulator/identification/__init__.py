"""Constants of an arm that its description leaves open, found from the data: gains of drives and inertias."""
