"""Sentences of the generator: models that are missing, damaged or unknown, by the code of the problem."""

from __future__ import annotations

from kirigami_studio.foundation.words import mark

SENTENCES: dict[str, str | tuple[str, str]] = {
    "model.unet_channels": mark(
        "The U-Net needs even numbers of at least 4 as channels, one for each level, got {channels}."
    ),
    "model.unet_levels": mark(
        "A U-Net of {levels} levels cannot halve {latent} pixels {halvings} times, or its mask of {mask} "
        "pixels is not a multiple of {latent}. Give it fewer levels."
    ),
    "model.unknown_backbone": mark(
        "This version does not know the network '{backbone:.40}' of these weights. Install the latest version of "
        "Kirigami Studio."
    ),
    "model.weights_missing": mark(
        "The weights {file} of the model '{variant:.40}' are missing. Install Kirigami Studio again."
    ),
    "model.weights_damaged": mark(
        "The weights {file} are damaged (checksum {found}, expected {expected}). Install Kirigami Studio again."
    ),
    "model.weights_do_not_fit": mark(
        "The weights {file} do not fit the network that their list describes. Install Kirigami Studio again."
    ),
    "model.weights_not_listed": mark(
        "The list of models in {folder} does not name {file}. Choose a file that training wrote."
    ),
    "model.list_unreadable": mark("Cannot read the list of models in {folder}. Install Kirigami Studio again."),
    "model.list_of_other_format": mark(
        "The list of models in {folder} has a format that this version cannot read. Install the latest "
        "version of Kirigami Studio."
    ),
    "model.unknown_variant": mark("There is no generator variant '{variant:.40}'. Choose one of {choices}."),
}
