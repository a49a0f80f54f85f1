"""Messages of the topics as bytes: CDR, the serialisation of ROS 2, for whole columns at once."""
