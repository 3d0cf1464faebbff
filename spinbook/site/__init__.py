"""The course's website: pages made from the executed notebooks, by Sphinx and a theme of our own."""
