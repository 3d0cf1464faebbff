"""A class of students and the results of grading them."""
