"""Rows of a database that tests break."""

PAGE_BYTES = 4096
# Short rows, rows of a few hundred bytes, and rows of several pages.
LENGTHS = (3, 300, 9_000)
ROWS = [
    ("/left" if number % 3 else "/right", 10**18 + number, "x" * LENGTHS[number % len(LENGTHS)])
    for number in range(300)
]
STAMPS = [row[1] for row in ROWS]
