"""The report of a diagnosis, in words for the terminal and as one self-contained HTML page, for every machine.

`words` and `summary` need nothing but numpy; `page` fills its template with jinja2.
"""
