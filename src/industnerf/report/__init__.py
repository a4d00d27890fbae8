"""The report: everything that is made of scores, clouds and costs."""
