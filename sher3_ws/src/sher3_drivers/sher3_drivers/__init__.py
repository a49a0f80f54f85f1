"""CAN motor drivers, force sensor and pedal of the SHER 3.0, with mock back-ends that speak the same wire protocols."""
