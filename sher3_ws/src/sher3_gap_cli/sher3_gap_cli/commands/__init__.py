"""The commands of `sher3 gap`, one module each; what several of them need stands beside this folder."""
