"""A robot that speaks NAOqi and needs no hardware: for tests, demonstrations and rehearsals."""
