"""What the paper compares with: searches of the ratio field, and conditional generators that draw it from a mask."""
