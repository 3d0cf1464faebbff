"""`spinbook submit`: one file to upload, with the student's code and what the public checks say of it."""
