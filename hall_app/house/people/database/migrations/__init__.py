"""Steps from one schema of the people's tables to the next."""
