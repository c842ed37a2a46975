"""The protocol as a resumable graph of stages."""
