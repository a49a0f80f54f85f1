"""The causes of one axis: how they are looked for, what a record cannot tell apart, and their numbers refined."""
