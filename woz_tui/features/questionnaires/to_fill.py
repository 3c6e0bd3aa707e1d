"""What stands in a template where its authors' wording belongs."""

#: `woz check` refuses a questionnaire in which it stands.
TO_FILL = "TO FILL"
