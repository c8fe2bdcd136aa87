"""What every command begins with: logs, models and topics as the user names them."""
