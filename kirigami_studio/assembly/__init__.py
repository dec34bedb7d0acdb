"""Designs of several pieces: panels in two layers on pins, tiles on a hinge layer."""
