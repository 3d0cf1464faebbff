"""`%check`: the public checks of an exercise, run on the code of the student's cell, and shown below it."""
