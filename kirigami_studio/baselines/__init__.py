"""What the paper compares with: searches of the ratio field, judged on the same evaluator as the program's own way."""
