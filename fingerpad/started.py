"""Start the libraries where no program has: imported first by what scripts of one's own import."""

from fingerpad.startup import start

start()
