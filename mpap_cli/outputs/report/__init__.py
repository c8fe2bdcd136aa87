"""report.html: everything found in a results folder on one page, without network."""
