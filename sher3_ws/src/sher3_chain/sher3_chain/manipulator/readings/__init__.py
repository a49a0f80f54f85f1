"""What the readings of an arm are worth: wrong ones, late ones, which encoder is believed, and their floors."""
