"""The record of processing (GDPR Art. 30) and what visitors are told (Art. 13), as a page made from the settings."""
