"""Figures and tables of an experiment, made of its results and what its config asks for."""
