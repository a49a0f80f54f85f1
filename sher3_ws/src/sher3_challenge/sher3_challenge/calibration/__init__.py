"""The calibration of the judgement: evidence of labelled cases, fitted on some plants and shown on the one left out."""
